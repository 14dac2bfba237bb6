"""Limits on the work of the interpretation, so that it ends in reasonable time on every program.

The unit is an executed statement; other work is converted to statements. A program is a file that is run, with its
imports; each has its own budget. A root is a module's top level, a callback, a timer, a thread or an entry point.
Calls beyond a limit are treated like calls of unknown library functions: the result depends on all arguments. See
docs/analysis.md.
"""

from __future__ import annotations

MAX_CALLS = 24  # maximum depth of the call stack; deeper calls are treated as library calls
# maximum number of calls of one method on the call stack at the same time, each for a different object
MAX_DELEGATIONS = 6
READS_PER_STATEMENT = 20  # number of object reads or added edges that count as one statement of work
VALUES_PER_STATEMENT = 40  # number of values shared at a wait that count as one statement of work
# number of values that take as long as one statement to look up, compare or copy in bulk (measured); this work
# counts towards the limits, but does not influence the order in which roots run
VALUES_HANDLED = 300
MAX_FRAMES = 20_000  # maximum number of call contexts of a program
# maximum number of statements in one run of a root; afterwards, calls are treated as library calls
MAX_STATEMENTS = 25_000
# after this number of statements in one run of a root, the calls of a frequently called function share a context
SEPARATE_STATEMENTS = 3_000
# maximum number of calls of a function in separate contexts; further calls share one context
SEPARATE_CALLS = 8
# after this number of statements of a program, the only roots to run are those that have not run yet; after twice
# this number, no root is run
PROGRAM_LIMIT = 80_000
# maximum number of statements in one run of a root, after its program has reached PROGRAM_LIMIT
LATE_RUN_LIMIT = 400
# maximum number of statements in an irrelevant call, which passes no data and enters a module that does not
# subscribe or publish
IRRELEVANT_CALL_LIMIT = 200
IRRELEVANT_CALLS_LIMIT = 1_000  # maximum number of statements in all irrelevant calls of one run of a root
MAX_ROUNDS = 40  # maximum number of fixpoint rounds over the roots
LARGE_RUN = 500  # a root whose last run took at least this many statements is run after smaller ones
MAX_GENERATIONS = 1  # maximum number of nested restarts of a thread or callback that starts itself
# two limits on the objects of one class: how many get separate roots for a method that a thread or framework runs,
# and how many code outside the files passes to a function
MAX_ALIKE = 6
# maximum number of unrolled iterations of a loop that registers something or makes objects of analysed classes
MAX_ROWS = 48
MAX_NESTED_ROWS = 96  # maximum number of iterations of all nested unrolled loops of one function together
MAX_APART = 48  # maximum number of sources, or sinks, that are distinguished by their topics at one call
