// Linked into programs built with a sanitizer: prevents libraries from being unloaded. The Vulkan loader unloads its
// drivers and layers. AddressSanitizer would then report allocations that these libraries keep on purpose, without
// naming the library; and ThreadSanitizer stops if a library named by a suppression is loaded a second time.

extern "C" int dlclose(void*)
{
    return 0;
}
