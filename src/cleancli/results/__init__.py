"""What the rows of a study come to: means, comparisons, verdicts, figures, and the page of them all."""
