"""Limits on the work of the interpretation, so that it ends in reasonable time on every program.

The unit is an executed statement; other work is converted to it. A program is a file that is run, with its imports;
each has its own budget. A root is a module's top level, a callback, a timer, a thread or an entry point. Calls beyond
a limit are treated like calls of unknown library functions: the result depends on all arguments. See
docs/analysis.md.
"""

from __future__ import annotations

MAX_CALLS = 24  # depth of the call stack; deeper calls count as library calls
LOOKS = 20  # object reads and added edges that cost as much as a statement
MAX_FRAMES = 20_000  # call contexts of a program
MAX_STATEMENTS = 25_000  # statements in one run of a root; later calls count as library calls
MANY = 3_000  # statements in one run of a root; then frequently called functions share a context
OFTEN = 8  # calls of one function after which its further calls share a context
PATIENCE = (
    80_000  # statements of a program; then only roots that have not run yet run, and none after twice as many
)
LEISURE = 200  # statements of a call without data into modules that neither subscribe nor publish
ALL_LEISURE = 1_000  # statements of all such calls in one run of a root
HASTE = 400  # statements in one run of a root once the program's budget (PATIENCE) is spent
MAX_ROUNDS = 40  # fixpoint rounds over the roots
LARGE = 500  # a root whose last run took this many statements waits for smaller ones
EXCHANGED = 40  # values shared at a wait that cost as much as a statement
MAX_GENERATIONS = 1  # nested restarts of threads and callbacks that start themselves
MAX_ALIKE = 6  # objects of a class whose method a thread or framework runs separately
