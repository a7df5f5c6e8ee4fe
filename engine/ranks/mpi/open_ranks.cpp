#include <cstdlib>
#include <string>

#include "engine/ranks/mpi/mpi_ranks.h"

namespace shvr {

namespace {

/// Value of the first variable that a launcher has set: OpenMPI's mpirun, PMIx (srun --mpi=pmix), PMI (MPICH).
const char* launcher_says(std::initializer_list<const char*> names)
{
    for (const char* name : names)
        if (const char* value = std::getenv(name)) return value;
    return nullptr;
}

}  // namespace

std::unique_ptr<Ranks> open_ranks()
{
    // Without a launcher, MPI_Init would start a daemon.
    if (!launcher_says({"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"})) return std::make_unique<OneRank>();
    return std::make_unique<MpiRanks>();
}

int launched_rank()
{
    const char* rank = launcher_says({"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"});
    return rank ? std::atoi(rank) : 0;
}

std::optional<std::string> why_not_shared()
{
    return std::nullopt;
}

}  // namespace shvr
