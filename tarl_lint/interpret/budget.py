"""Limits on the work of the interpretation, so that it ends in reasonable time on every program.

The unit is an executed statement; other work is converted to statements. A program is a file that is run, with its
imports; each has its own budget. A root is a module's top level, a callback, a timer, a thread or an entry point.
Calls beyond a limit are treated like calls of unknown library functions: the result depends on all arguments. See
docs/analysis.md.
"""

from __future__ import annotations

MAX_CALLS = 24  # depth of the call stack; deeper calls count as library calls
READS_PER_STATEMENT = 20  # object reads or added edges that cost as much as one statement
VALUES_PER_STATEMENT = 40  # values shared at a wait that cost as much as one statement
MAX_FRAMES = 20_000  # call contexts of a program
MAX_STATEMENTS = 25_000  # statements in one run of a root; later calls count as library calls
# statements in one run of a root after which frequently called functions share a context
SEPARATE_STATEMENTS = 3_000
SEPARATE_CALLS = 8  # calls of one function after which its further calls share a context
# statements of a program; beyond that, only roots that never ran are run; beyond twice that, none
PROGRAM_LIMIT = 80_000
LATE_RUN_LIMIT = 400  # statements in one run of a root once its program has reached PROGRAM_LIMIT
# statements of one call without data among its arguments, into a module that neither subscribes nor publishes
IRRELEVANT_CALL_LIMIT = 200
IRRELEVANT_CALLS_LIMIT = 1_000  # statements of all such calls in one run of a root
MAX_ROUNDS = 40  # fixpoint rounds over the roots
LARGE_RUN = 500  # a root whose last run took this many statements waits for smaller ones
MAX_GENERATIONS = 1  # nested restarts of threads and callbacks that start themselves
# objects of one class that get separate roots for a method that a thread or framework runs
MAX_ALIKE = 6
