"""What rules about races ask: locks that are held, threads, accesses."""
