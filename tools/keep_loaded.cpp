// Linked into programs built with a sanitizer: libraries stay loaded to the end. The Vulkan loader closes its drivers
// and layers. AddressSanitizer would report what those keep for the life of the process without a name that tells whose
// it is, and ThreadSanitizer refuses to go on when a library that a suppression names is loaded a second time.

extern "C" int dlclose(void*)
{
    return 0;
}
