#pragma once
// The parts of a flower head that the groups of a trace stand for (thesis 5.2). Any thread may call these.

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace shvr {

enum class HeadPart : uint8_t { none, abaxial, adaxial, floret };
inline constexpr HeadPart HEAD_PARTS[] = {HeadPart::abaxial, HeadPart::adaxial, HeadPart::floret};
const char* name_of(HeadPart part);

struct HeadSections {
    std::array<HeadPart, 256> parts{};  ///< part of each group
    bool is_stated = false;             ///< by an option or by names of groups, not by the thesis's numbers alone
    /// Groups of a part, "2" or "2+5"; "none" if there are none.
    std::string groups_of(HeadPart part) const;
};

/// A group as far as sections need it.
struct SectionGroup {
    std::string name{};  ///< empty: it has none
    uint8_t parent = 0;  ///< 0: none
};

/// Returns the part of each group. `stated`, such as "abaxial=1+4,adaxial=2,floret=3", decides if it is not empty; else
/// names of groups that contain exactly one of the words abaxial, stem, bract (all abaxial), adaxial, floret; parts
/// without such a group have the thesis's, 1, 2 and 3, unless its name states another part. Descendants of a group are
/// of its part unless they have their own. Fails with a sentence that begins with `option` if `stated` is malformed.
HeadSections head_sections(const std::string& stated, const std::string& option,
                           const std::function<SectionGroup(uint8_t)>& group);

}  // namespace shvr
