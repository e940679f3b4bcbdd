"""Names of polyrecon's layers. tests/docs/test_driver_names.py compares them with src/io/renderers/polyrecon.h."""

VARIANCE_SUFFIX = " Variance"  # variance of the mean of a layer
HALF_A_SUFFIX, HALF_B_SUFFIX = " A", " B"  # means over two independent halves of its samples
SAMPLE_COUNT_PASS = "Sample Count"
