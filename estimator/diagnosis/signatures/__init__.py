"""What causes would leave in the residuals, and the score of each signature."""
