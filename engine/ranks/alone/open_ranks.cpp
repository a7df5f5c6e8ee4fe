#include <cstdlib>
#include <string_view>

#include "engine/base/error.h"
#include "engine/ranks/ranks.h"

namespace shvr {

std::unique_ptr<Ranks> open_ranks()
{
    return std::make_unique<OneRank>();
}

int launched_rank()
{
    return 0;
}

std::optional<std::string> why_not_shared()
{
    const char *count = std::getenv("OMPI_COMM_WORLD_SIZE"), *rank = std::getenv("OMPI_COMM_WORLD_RANK");
    if (!count || !rank || std::string_view(count) == "1" || std::string_view(rank) != "0") return std::nullopt;
    return sentence("mpirun started ", count,
                    " processes, and each draws the whole picture, since shvr was built without MPI; build it with "
                    "-DSHVR_MPI=ON to draw one picture together");
}

}  // namespace shvr
