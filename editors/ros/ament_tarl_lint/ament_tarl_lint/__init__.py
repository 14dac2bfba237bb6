"""Run tarl-lint as a linter of an ament package."""
