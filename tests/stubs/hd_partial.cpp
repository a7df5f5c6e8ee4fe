// A libHD.so of another version: it has the first function only.

#include <cstdint>

extern "C" uint32_t hdInitDevice(const char*)
{
    return 0xffffffff;
}
