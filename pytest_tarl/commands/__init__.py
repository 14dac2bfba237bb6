"""The command `tarl`: inspect recordings, apply patches and watch robots, without pytest."""
