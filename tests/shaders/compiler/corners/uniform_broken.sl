// error: a value that varies is assigned to uniform 'k'
surface uniform_broken() { uniform float k = s; Ci = k; }
