#define STRING(x) #x
#define PASTE(a, b) a##b
#define SQR(x) ((x) * (x))
#define snoise(x) (2 * (float noise(x)) - 1)
#if defined(NOT_THERE) || !(4 % 3 == 1) || (1 ? 0 : 1)
#error this must not be read
#elif defined SQR && __LINE__ == 7
#define REACHED 1
#endif
surface preprocessor() {
    float PASTE(val, ue) = SQR(1 + 2);
    float bounded = abs(snoise(P)) <= 1;
    Ci = color (0, value == 9 && REACHED == 1 && STRING(a + b) == "a + b" && bounded == 1, 0);
}
