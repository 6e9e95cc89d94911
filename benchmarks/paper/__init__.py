"""The technical report and the slides: texts with numbers filled in, as pages that print."""
