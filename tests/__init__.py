"""Tests of the project, in folders by kind of evidence."""
