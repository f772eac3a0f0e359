"""Another reading of docs/language.md and docs/planning.md, written from these pages alone, and random
domains on which the product is compared with it."""
