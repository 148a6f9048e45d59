"""Tests, in folders by kind of evidence."""
