"""Tests of every FMU against a checklist of rules of FMI 2.0.5; the rules have numbers from 1 to 16."""
