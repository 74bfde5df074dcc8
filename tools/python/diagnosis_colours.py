"""What is drawn in which colour on the pages of a diagnosis."""

MEASURED = "#222222"
BEFORE = "#c44e52"  # the nominal machine
AFTER = "#2a7f9e"   # with what was found
CURVES = ("#2a7f9e", "#dd8452", "#55a868", "#8172b3", "#937860", "#da8bc3")  # several in one picture
