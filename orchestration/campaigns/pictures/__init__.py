"""Pictures of a study's table: marginals, heat maps, boundaries, spread over seeds, sensitivities."""
