#include "engine/graph/kernel_variants.h"

#include <algorithm>
#include <cctype>

#include "engine/base/error.h"

namespace shvr {

namespace {

std::string in_words(std::span<const std::string_view> macros)
{
    if (macros.empty()) return "none";
    std::string words;
    for (const std::string_view macro : macros) words += (words.empty() ? "" : " ") + std::string(macro);
    return words;
}

}  // namespace

std::string variant_of(std::string_view kernel, std::initializer_list<VariantChoice> choices,
                       std::span<const KernelVariants> known)
{
    const auto found = std::ranges::find(known, kernel, &KernelVariants::kernel);
    const std::span<const std::string_view> macros =
        found == known.end() ? std::span<const std::string_view>{} : found->macros;
    const auto refuse = [&](const char* what, std::string_view macro) {
        fail("variant ", macro, " of kernel '", kernel, "' ", what, "; it has ", in_words(macros));
    };
    for (const VariantChoice& choice : choices) {
        if (std::ranges::find(macros, choice.macro) == macros.end()) refuse("is unknown", choice.macro);
        if (std::ranges::count(choices, choice.macro, &VariantChoice::macro) > 1)
            refuse("is chosen twice", choice.macro);
    }
    std::string name(kernel);
    for (const std::string_view macro : macros) {
        const auto choice = std::ranges::find(choices, macro, &VariantChoice::macro);
        if (choice == choices.end()) refuse("is not chosen", macro);
        if (!choice->is_on) continue;
        name += '_';
        for (const char letter : macro) name += char(std::tolower(static_cast<unsigned char>(letter)));
    }
    return name;
}

std::string variant_of(std::string_view kernel, std::initializer_list<VariantChoice> choices)
{
    return variant_of(kernel, choices, kernel_variants());
}

}  // namespace shvr
