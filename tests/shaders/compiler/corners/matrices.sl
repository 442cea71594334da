surface matrices(matrix shape = matrix "shader" 1; matrix pair[2] = {1, 3};) {
    matrix m = (1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1);
    matrix grid[3];
    grid[1] = m * translate(1, vector (1, 1, 1));
    grid[2] = 1 / grid[1];
    point p = transform(grid[2], transform(grid[1], P));
    setcomp(grid[0], 1, 2, 7);
    float d = determinant(m);
    matrix half = pair[1] / 2;
    Ci = color (0, distance(p, P) < 0.0001 && comp(grid[0], 1, 2) == 7 && d == 2 && comp(half, 0, 0) == 1.5
                   && comp(shape, 3, 3) == 1, 0);
}
