// Linked into programs built with a sanitizer: libraries stay loaded to the end. The Vulkan loader closes its drivers
// and layers. AddressSanitizer would report their process-lifetime allocations without naming the library, and
// ThreadSanitizer stops if a library named by a suppression is loaded a second time.

extern "C" int dlclose(void*)
{
    return 0;
}
