"""Requirements as formulas of signal temporal logic over named signals.

The package rtamt is imported only when a formula is used.
"""
