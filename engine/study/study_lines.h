#pragma once
// The lines of a study's CSV files (RFC 4180 without quotes): a header, then one line of fields per row. Any thread.

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/study/rows.h"

namespace shvr {

/// Parses the fields of one line. Error messages name the line's place and the column.
struct StudyLine {
    std::string place;
    std::span<const std::string_view> names;
    std::vector<std::string_view> fields;  ///< one for each name

    [[noreturn]] void refuse(size_t field, std::string_view expected) const;
    template <class Value>
    Value spelled_value(size_t field) const
    {
        std::string expected = "one of";
        for (const Spelling<Value>& each : spellings_of(Value{})) {
            if (each.name == fields[field]) return each.value;
            expected.append(" ").append(each.name);
        }
        refuse(field, expected);
    }
    double number(size_t field) const;
    double number_or_nan(size_t field) const;  ///< NaN for an empty field
    uint32_t whole(size_t field) const;
    StudyCondition condition() const;  ///< read from the first five fields
};

/// The line of names, with its end.
std::string study_header(std::span<const std::string_view> names);

/// Calls `take` with each line after the header. Fails with a message that names file and line if the header differs
/// from the expected one, or if a line has the wrong number of fields.
void read_study_lines(const std::filesystem::path& file, std::span<const std::string_view> names,
                      const std::function<void(const StudyLine&)>& take);

}  // namespace shvr
