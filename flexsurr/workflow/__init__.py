"""What the Snakefile asks: which jobs there are, on what values and on what code each depends."""
