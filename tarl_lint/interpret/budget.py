"""How much work is done at most, so that no program takes for ever.

Counted in statements, looks into objects, edges, activations and rounds; each program, which is a file that is run and
what it imports, has a budget of its own.
"""

from __future__ import annotations

MAX_CALLS = 24  # nested calls that are told apart; deeper ones are taken for library calls
LOOKS = 20  # looks into objects, elements read and edges added that take as long as a statement
MAX_FRAMES = 20_000  # activations of a program
MAX_STATEMENTS = 25_000  # executed in one run of a root; then calls are taken for library calls
MANY = 3_000  # statements in one run of a root, after which calls of functions that ran often share a context
OFTEN = 8  # runs of one function in one run of a root that is as long as that
PATIENCE = (
    80_000  # statements of a program; then what did not run yet runs once, and at twice as many nothing more
)
LEISURE = 200  # statements of a call into modules that take no part, when no data goes in
ALL_LEISURE = 1_000  # statements of all such calls in one run of a root
HASTE = 400  # statements in one run of a root after that
MAX_ROUNDS = 40  # of what runs on its own
LARGE = 500  # statements in the last run of a root that waits until smaller ones have nothing to do
EXCHANGED = 40  # values that a root shares while it waits, in the time of a statement
MAX_GENERATIONS = 1  # of threads and callbacks that start themselves anew
MAX_ALIKE = 6  # objects of a class for which a thread or a framework runs a method
