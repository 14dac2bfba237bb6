"""Write repairs into source code: changed constants, guards, new subscriptions, diffs."""
