"""Limits on the work of the interpretation, so that it ends in reasonable time on every program.

The unit is an executed statement; other work is converted to statements. A program is a file that is run, with its
imports; each has its own budget. A root is a module's top level, a callback, a timer, a thread or an entry point.
Calls beyond a limit are treated like calls of unknown library functions: the result depends on all arguments. See
docs/analysis.md.
"""

from __future__ import annotations

MAX_CALLS = 24  # depth of the call stack; deeper calls count as library calls
LOOKS = 20  # as many object reads or added edges cost as much as a statement
MAX_FRAMES = 20_000  # call contexts of a program
MAX_STATEMENTS = 25_000  # statements in one run of a root; later calls count as library calls
MANY = 3_000  # statements in one run of a root; beyond that, frequently called functions share a context
OFTEN = 8  # calls of one function after which its further calls share a context
PATIENCE = (
    80_000  # statements of a program; beyond that, only roots that never ran are run; beyond twice that, none
)
# statements of one call that passes no data into a module that neither subscribes nor publishes
LEISURE = 200
ALL_LEISURE = 1_000  # statements of all such calls in one run of a root
HASTE = 400  # statements in one run of a root once the program's budget (PATIENCE) is spent
MAX_ROUNDS = 40  # fixpoint rounds over the roots
LARGE = 500  # a root whose last run took this many statements waits for smaller ones
EXCHANGED = 40  # as many values shared at a wait cost as much as a statement
MAX_GENERATIONS = 1  # nested restarts of threads and callbacks that start themselves
# objects of one class for each of which a method run by a thread or framework is a root of its own
MAX_ALIKE = 6
