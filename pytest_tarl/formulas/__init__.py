"""Requirements in signal temporal logic over named signals; rtamt is imported only when a formula is used."""
