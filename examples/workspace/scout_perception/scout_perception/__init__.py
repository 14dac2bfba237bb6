"""An example of TARL: obstacles from a laser scan."""
