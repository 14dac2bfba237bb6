"""`--tarl-stress`: the nearest drifts of a space under which the guarantee of a recording fails."""
