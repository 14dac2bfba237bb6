"""Questions of the plugin about constants at a site."""
