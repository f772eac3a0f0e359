"""Studies: which episodes are carried out, what is compared with what, and the rows that tell how it went."""
