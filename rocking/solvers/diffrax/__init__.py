"""JAX and Diffrax: any system of plain functions, with forward derivatives through impacts (`response`)."""
