#include "helpers.h"
#include <helpers.h>
surface includes() {
    Ci = color (0, near(half(3), 1.5), 0);
}
