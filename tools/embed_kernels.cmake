# Writes OUTPUT, a C++ file that embeds the SPIR-V files BINARIES, so that `shvr` is one file that runs anywhere. Also
# lists the macros that each kernel may be compiled with. Run by the build:
#   cmake -DOUTPUT=... -DBINARIES=a.spv;b.spv "-DVARIANTS=raycast PAGED MASKED;surfaces LISTED" -P embed_kernels.cmake
#
# The assembler includes the files: as lists of numbers they would be 50 MB of C++, half a minute to write and compile.
set(arrays "")
set(entries "")
foreach(binary IN LISTS BINARIES)
    cmake_path(GET binary STEM name)
    # SPIR-V is a stream of 32-bit words. glslang writes them in the byte order of the machine, which is the same on all
    # machines that build SHVR.
    file(SIZE ${binary} bytes)
    math(EXPR words "${bytes} / 4")
    string(APPEND arrays "EMBED(${name}, \"${binary}\")\n")
    string(APPEND entries "    {\"${name}\", shvr_kernel_${name}, ${words}},\n")
endforeach()
set(variants "")
set(tables "")
foreach(line IN LISTS VARIANTS)
    string(REPLACE " " ";" macros "${line}")
    list(POP_FRONT macros name)
    list(TRANSFORM macros REPLACE "(.+)" "\"\\1\"")
    list(JOIN macros ", " macros)
    string(APPEND tables "constexpr std::string_view ${name}_macros[] = {${macros}};\n")
    string(APPEND variants "    {\"${name}\", ${name}_macros},\n")
endforeach()
set(kernel_variants "{}")
if(variants)
    string(APPEND tables "constexpr KernelVariants variants[] = {\n${variants}};\n")
    set(kernel_variants "gpu::variants")
endif()
set(kernels "{}")
if(entries)
    string(APPEND tables "constexpr EmbeddedKernel kernels[] = {\n${entries}};\n")
    set(kernels "kernels")
endif()
file(WRITE ${OUTPUT} "// Made by tools/embed_kernels.cmake.
#include \"engine/gpu/embedded_kernels.h\"
#include \"engine/graph/kernel_variants.h\"

// The words of a file as an array in read-only memory. Hidden: the address is a constant of the program.
#define EMBED(name, file) \\
    asm(\".pushsection .rodata\\n\" \\
        \".balign 4\\n\" \\
        \".globl shvr_kernel_\" #name \"\\n\" \\
        \".hidden shvr_kernel_\" #name \"\\n\" \\
        \"shvr_kernel_\" #name \":\\n\" \\
        \".incbin \\\"\" file \"\\\"\\n\" \\
        \".popsection\"); \\
    extern \"C\" [[gnu::visibility(\"hidden\")]] const uint32_t shvr_kernel_##name[];
${arrays}
namespace shvr::gpu {
namespace {
${tables}}  // namespace

std::span<const EmbeddedKernel> embedded_kernels()
{
    return ${kernels};
}

}  // namespace shvr::gpu

namespace shvr {

std::span<const KernelVariants> kernel_variants()
{
    return ${kernel_variants};
}

}  // namespace shvr
")
