"""Signatures of causes in the residuals, with the score of each."""
