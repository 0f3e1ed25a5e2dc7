"""Studies of what careful people find in files and sessions, by generators that share no code with the estimator."""
