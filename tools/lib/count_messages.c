/* Count the messages that a rank sends and the bytes in them, by kind, through MPI's profiling
   interface: tools/bench scale and effects load this before LAMMPS. At the end each rank writes a
   line

     messages bytes    point-to-point, allreduce, allgather, alltoall, others
     memory at the start and at the end, bytes
     bytes in use of what was allocated, at the last global sum; 0 where the C library cannot tell

   to the file $DCM_COUNTS.RANK. Bytes of point-to-point messages are those sent; of collective
   calls those that end up on the rank, which is what grows with the number of ranks. The last
   global sum is one of LAMMPS' summary of a run, when all styles are still there. */

#include <malloc.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

enum { POINT, ALLREDUCE, ALLGATHER, ALLTOALL, OTHER, NKIND };

static long long messages[NKIND], bytes[NKIND];
static long long memory_at_start, allocated;

static void count(int kind, MPI_Datatype type, long long n)
{
  int size = 0;
  PMPI_Type_size(type, &size);
  messages[kind]++;
  bytes[kind] += n * size;
}

static int ranks(MPI_Comm comm)
{
  int n;
  PMPI_Comm_size(comm, &n);
  return n;
}

static long long total(const int *counts, MPI_Comm comm)
{
  long long sum = 0;
  for (int p = 0; p < ranks(comm); p++) sum += counts[p];
  return sum;
}

static long long resident(void)
{
  long long pages = 0;
  FILE *f = fopen("/proc/self/statm", "r");
  if (f && fscanf(f, "%*s %lld", &pages) != 1) pages = 0;
  if (f) fclose(f);
  return 4096 * pages;
}

static long long in_use(void)
{
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
  const struct mallinfo2 m = mallinfo2();
  return (long long) (m.uordblks + m.hblkhd);
#else
  return 0;
#endif
}

#define SEND(NAME)                                                                              \
  int MPI_##NAME(const void *b, int n, MPI_Datatype t, int to, int tag, MPI_Comm c)              \
  {                                                                                              \
    count(POINT, t, n);                                                                          \
    return PMPI_##NAME(b, n, t, to, tag, c);                                                     \
  }
#define ISEND(NAME)                                                                             \
  int MPI_##NAME(const void *b, int n, MPI_Datatype t, int to, int tag, MPI_Comm c,              \
                 MPI_Request *r)                                                                 \
  {                                                                                              \
    count(POINT, t, n);                                                                          \
    return PMPI_##NAME(b, n, t, to, tag, c, r);                                                  \
  }
SEND(Send)
SEND(Ssend)
SEND(Rsend)
ISEND(Isend)
ISEND(Irsend)

int MPI_Sendrecv(const void *b, int n, MPI_Datatype t, int to, int tag, void *rb, int rn,
                 MPI_Datatype rt, int from, int rtag, MPI_Comm c, MPI_Status *s)
{
  count(POINT, t, n);
  return PMPI_Sendrecv(b, n, t, to, tag, rb, rn, rt, from, rtag, c, s);
}

int MPI_Allreduce(const void *b, void *r, int n, MPI_Datatype t, MPI_Op op, MPI_Comm c)
{
  count(ALLREDUCE, t, n);
  allocated = in_use();
  return PMPI_Allreduce(b, r, n, t, op, c);
}

int MPI_Allgather(const void *b, int n, MPI_Datatype t, void *r, int rn, MPI_Datatype rt,
                  MPI_Comm c)
{
  count(ALLGATHER, rt, (long long) rn * ranks(c));
  return PMPI_Allgather(b, n, t, r, rn, rt, c);
}

int MPI_Allgatherv(const void *b, int n, MPI_Datatype t, void *r, const int *rn, const int *at,
                   MPI_Datatype rt, MPI_Comm c)
{
  count(ALLGATHER, rt, total(rn, c));
  return PMPI_Allgatherv(b, n, t, r, rn, at, rt, c);
}

int MPI_Alltoall(const void *b, int n, MPI_Datatype t, void *r, int rn, MPI_Datatype rt, MPI_Comm c)
{
  count(ALLTOALL, rt, (long long) rn * ranks(c));
  return PMPI_Alltoall(b, n, t, r, rn, rt, c);
}

int MPI_Alltoallv(const void *b, const int *n, const int *at, MPI_Datatype t, void *r,
                  const int *rn, const int *rat, MPI_Datatype rt, MPI_Comm c)
{
  count(ALLTOALL, rt, total(rn, c));
  return PMPI_Alltoallv(b, n, at, t, r, rn, rat, rt, c);
}

int MPI_Bcast(void *b, int n, MPI_Datatype t, int root, MPI_Comm c)
{
  count(OTHER, t, n);
  return PMPI_Bcast(b, n, t, root, c);
}

int MPI_Reduce(const void *b, void *r, int n, MPI_Datatype t, MPI_Op op, int root, MPI_Comm c)
{
  count(OTHER, t, n);
  return PMPI_Reduce(b, r, n, t, op, root, c);
}

int MPI_Reduce_scatter(const void *b, void *r, const int *n, MPI_Datatype t, MPI_Op op, MPI_Comm c)
{
  count(OTHER, t, total(n, c));
  return PMPI_Reduce_scatter(b, r, n, t, op, c);
}

int MPI_Scan(const void *b, void *r, int n, MPI_Datatype t, MPI_Op op, MPI_Comm c)
{
  count(OTHER, t, n);
  return PMPI_Scan(b, r, n, t, op, c);
}

int MPI_Barrier(MPI_Comm c)
{
  count(OTHER, MPI_BYTE, 0);
  return PMPI_Barrier(c);
}

int MPI_Init(int *argc, char ***argv)
{
  const int result = PMPI_Init(argc, argv);
  memory_at_start = resident();
  return result;
}

int MPI_Finalize(void)
{
  int me;
  char name[4096];
  const char *const file = getenv("DCM_COUNTS");
  PMPI_Comm_rank(MPI_COMM_WORLD, &me);
  snprintf(name, sizeof(name), "%s.%d", file ? file : "counts", me);
  FILE *f = fopen(name, "w");
  if (f) {
    for (int k = 0; k < NKIND; k++) fprintf(f, "%lld %lld ", messages[k], bytes[k]);
    fprintf(f, "%lld %lld %lld\n", memory_at_start, resident(), allocated);
    fclose(f);
  }
  return PMPI_Finalize();
}
