"""Which runs a study makes: factors, their levels, and samples of them."""
