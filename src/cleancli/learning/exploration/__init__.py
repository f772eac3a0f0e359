"""Where experience is wanted: what is known of which actions in which states, and plans towards the rest."""
