surface empty() { ; {} if (1) ; else ; for (;0;) ; Ci = color (0, 1, 0); ; }
