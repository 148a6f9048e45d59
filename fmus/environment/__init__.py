"""What the tip of an arm touches: where it is, and which force it exerts."""
