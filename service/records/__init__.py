"""What flows between the rooms: frozen records, complete at birth, one definition each. SI inside."""
