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
    bool is_stated = false;             ///< by an option or groups' names, rather than the thesis's numbers only
    /// Numbers of a part's groups, such as "2" or "2+5"; "none" if it has no group.
    std::string groups_of(HeadPart part) const;
};

/// The properties of a group that determine its part.
struct SectionGroup {
    std::string name{};  ///< empty: it has none
    uint8_t parent = 0;  ///< 0: none
};

/// Returns the part of each group. If `stated`, such as "abaxial=1+4,adaxial=2,floret=3", is not empty, it decides.
/// Otherwise the words abaxial, stem, bract (all abaxial), adaxial and floret in names decide, if a name contains words
/// of one part only; a part without such a group gets the thesis's group (1, 2 or 3) unless its name states another
/// part. Descendants inherit a group's part unless they have their own. Errors about `stated` begin with `option`.
HeadSections head_sections(const std::string& stated, const std::string& option,
                           const std::function<SectionGroup(uint8_t)>& group);

}  // namespace shvr
