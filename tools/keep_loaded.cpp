// Linked into programs built with a sanitizer: keeps libraries loaded to the end. The Vulkan loader unloads its drivers
// and layers. AddressSanitizer would then report their process-lifetime allocations without naming the library, and
// ThreadSanitizer stops if a library named by a suppression is loaded a second time.

extern "C" int dlclose(void*)
{
    return 0;
}
