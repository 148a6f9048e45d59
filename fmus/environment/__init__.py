"""What an arm touches."""
