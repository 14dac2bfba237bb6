"""Requirements as formulas of signal temporal logic over named signals; rtamt is imported where one is used."""
