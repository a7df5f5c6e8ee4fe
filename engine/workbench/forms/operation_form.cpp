#include "engine/workbench/forms/operation_form.h"

#include <cmath>
#include <cstdio>
#include <optional>
#include <string_view>

#include "engine/base/text.h"
#include "engine/tasks/task_options.h"

namespace shvr::ui {

double suggested_intensity(double threshold, VoxelType type)
{
    if (!is_float(type)) return std::ceil(threshold);
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", threshold);
    return number_of(text).value_or(threshold);
}

std::string with_label(const std::string& refusal)
{
    constexpr std::string_view KEY = "key ", IS = " is ", EXPECTED = "; expected ";
    const size_t is = refusal.find(IS), expected = refusal.find(EXPECTED);
    if (!refusal.starts_with(KEY) || is == std::string::npos || expected == std::string::npos || expected < is)
        return refusal;
    const std::string key = refusal.substr(KEY.size(), is - KEY.size());
    const std::string found = refusal.substr(is + IS.size(), expected - is - IS.size());
    const std::optional<double> number = number_of(found);
    return option_title(key) + std::string(IS) +
           (found == "missing" ? "empty"
            : number           ? plain_digits_of(*number)
                               : found) +
           refusal.substr(expected);
}

}  // namespace shvr::ui
