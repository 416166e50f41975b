// The calls of MPI and MUMPS that moreau makes, on plain numbers and addresses; no logic of its own but how long
// to wait. The structure of MUMPS is filled here, where its own header says what it looks like.

#define _POSIX_C_SOURCE 200809L
#include <dmumps_c.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <mpi.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

// Messages of moreau are apart from those of MUMPS.
static MPI_Comm ours = MPI_COMM_NULL;

int moreau_mpi_begin(int *rank, int *size) {
    int given = 0, begun = 0;
#ifdef __GLIBC__
    // Vectors over all unknowns are given back to the system when they are freed: what they leave between others is
    // room that nothing fits in, a tenth of a process.
    mallopt(M_MMAP_THRESHOLD, 4 << 20);
#endif
    MPI_Initialized(&begun);
    if (!begun && MPI_Init_thread(NULL, NULL, MPI_THREAD_SERIALIZED, &given) != MPI_SUCCESS)
        return 1;
    if (ours == MPI_COMM_NULL)
        MPI_Comm_dup(MPI_COMM_WORLD, &ours);
    MPI_Comm_rank(MPI_COMM_WORLD, rank);
    MPI_Comm_size(MPI_COMM_WORLD, size);
    return !begun && given < MPI_THREAD_SERIALIZED;
}

void moreau_mpi_end(void) {
    int ended = 0;
    MPI_Finalized(&ended);
    if (!ended)
        MPI_Finalize();
}

void moreau_mpi_abort(int status) { MPI_Abort(MPI_COMM_WORLD, status); }

// Messages are counted by int: those of any length go in parts.
static const uint64_t PART = 1u << 30;

void moreau_mpi_send(int to, const char *bytes, uint64_t length) {
    MPI_Send(&length, 1, MPI_UINT64_T, to, 1, ours);
    for (uint64_t at = 0; at < length; at += PART) {
        uint64_t part = length - at < PART ? length - at : PART;
        MPI_Send(bytes + at, (int)part, MPI_BYTE, to, 2, ours);
    }
}

// The length of the next message. Who waits long leaves the processor to others.
uint64_t moreau_mpi_await(int from) {
    uint64_t length = 0;
    int there = 0;
    struct timespec pause = {0, 0};
    for (int looks = 0; !there; ++looks) {
        MPI_Iprobe(from, 1, ours, &there, MPI_STATUS_IGNORE);
        if (!there && looks > 1000) {
            if (pause.tv_nsec < 1000000)
                pause.tv_nsec += 10000;
            nanosleep(&pause, NULL);
        }
    }
    MPI_Recv(&length, 1, MPI_UINT64_T, from, 1, ours, MPI_STATUS_IGNORE);
    return length;
}

void moreau_mpi_receive(int from, char *bytes, uint64_t length) {
    for (uint64_t at = 0; at < length; at += PART) {
        uint64_t part = length - at < PART ? length - at : PART;
        MPI_Recv(bytes + at, (int)part, MPI_BYTE, from, 2, ours, MPI_STATUS_IGNORE);
    }
}

static void run(DMUMPS_STRUC_C *m, int job) {
    m->job = job;
    dmumps_c(m);
}

DMUMPS_STRUC_C *moreau_mumps_new(int sym) {
    DMUMPS_STRUC_C *m = calloc(1, sizeof *m);
    if (!m)
        return NULL;
    m->comm_fortran = (MUMPS_INT)MPI_Comm_c2f(MPI_COMM_WORLD);
    m->par = 1;
    m->sym = sym;
    run(m, -1);
    return m;
}

void moreau_mumps_free(DMUMPS_STRUC_C *m) {
    run(m, -2);
    free(m);
}

// Counted from 1, as in the manual.
void moreau_mumps_set_integer(DMUMPS_STRUC_C *m, int which, int value) { m->icntl[which - 1] = value; }

void moreau_mumps_set_real(DMUMPS_STRUC_C *m, int which, double value) { m->cntl[which - 1] = value; }

int moreau_mumps_integer(const DMUMPS_STRUC_C *m, int which) { return m->infog[which - 1]; }

double moreau_mumps_real(const DMUMPS_STRUC_C *m, int which) { return m->rinfog[which - 1]; }

// Rows and columns count from 1 and must stay where they are as long as the instance.
void moreau_mumps_analyse(DMUMPS_STRUC_C *m, int n, int64_t entries, int *rows, int *columns, int kept, int *list,
                          int *order) {
    m->n = n;
    m->nnz_loc = entries;
    m->irn_loc = rows;
    m->jcn_loc = columns;
    m->perm_in = order;
    if (kept > 0) {
        m->size_schur = kept;
        m->listvar_schur = list;
    }
    run(m, 1);
}

void moreau_mumps_factorise(DMUMPS_STRUC_C *m, const double *values, double *schur, int kept) {
    m->a_loc = (double *)values; // which MUMPS only reads
    if (schur) {
        m->schur = schur;
        m->schur_lld = kept;
    }
    run(m, 2);
    m->a_loc = NULL;
    m->schur = NULL;
}

void moreau_mumps_solve(DMUMPS_STRUC_C *m, double *x, int n) {
    m->rhs = x;
    m->nrhs = 1;
    m->lrhs = n;
    run(m, 3);
    m->rhs = NULL;
}

// The first pivot that is zero, from 1; 0 where none is known.
int moreau_mumps_null_pivot(const DMUMPS_STRUC_C *m) {
    return m->pivnul_list && m->infog[27] > 0 ? m->pivnul_list[0] : 0;
}
