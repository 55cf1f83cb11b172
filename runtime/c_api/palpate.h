/* palpate: force-deflection responses of soft bodies, rendered passively.
 *
 * The C interface (C99) for simulators that drive the device themselves: position in,
 * force out. It needs no other header and no C++.
 *
 *   palpate_options options = {0};                       // zero: defaults
 *   options.struct_size = sizeof options;
 *   palpate_body* body = palpate_open("liver.h5", &options, error, sizeof error);
 *   palpate_tool* tool = palpate_tool_add(body);
 *   for (;;) palpate_force(tool, position, NULL, dt_s, force);   // at the haptic rate
 *   palpate_close(body);
 *
 * Frame: that of the body in its file, at rest, or the host's world (palpate_place()).
 * Lengths and forces in the host's units (options).
 *
 * Threads: a body's slow process runs in a thread of the library, unless
 * PALPATE_OWN_SLOW_STEPS. Every tool is used by one thread at a time, the haptic one;
 * different tools by different threads. palpate_state_get() may be called from one
 * other thread instead. palpate_open(), palpate_tool_add(), palpate_slow_step() and
 * palpate_slow_failure() may wait and allocate; palpate_close() when no other call is
 * under way. Functions of the haptic thread say so.
 *
 * No function throws, prints, or ends the process. Names of files are UTF-8.
 *
 * Guaranteed: the account. Work put in by the tool = stored + tank + dents + dissipated
 * (dents: memory_j), and none of the last four is below zero. It holds for positions as
 * they were measured, for elements and models exchanged in any order and however late.
 * Not guaranteed: the device holds a force from one tick to the next. While the tool
 * moves by dx, that gives the hand up to K |dx|^2 / 2 a tick beyond the account. The
 * device's own damping must take that: b >= K T / 2 (palpate_needed_damping()). K is
 * the largest curvature of the energy that is found over the body, where all nodes of
 * an element respond. The outermost elements of the reach may be steeper. Of a streamed
 * database K is the largest slope of its curves. "facets" does not keep to K: its force
 * steps at edges.
 */
#ifndef PALPATE_H
#define PALPATE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(_WIN32) && defined(PALPATE_BUILDING_LIBRARY)
#define PALPATE_API __declspec(dllexport)
#elif defined(_WIN32)
#define PALPATE_API __declspec(dllimport)
#elif defined(__GNUC__)
#define PALPATE_API __attribute__((visibility("default")))
#else
#define PALPATE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* C's names, not C++'s. NOLINTBEGIN(readability-identifier-naming) */

/* Counts up when a program built against an older header would not work any more. New
 * members go to the ends of structs, which struct_size tells apart. */
#define PALPATE_ABI_VERSION 1

/* What palpate_force() returns. A fault is latched: the force is zero until
 * palpate_reset(). */
enum palpate_status {
  PALPATE_FREE = 0,
  PALPATE_CONTACT = 1,
  PALPATE_FAULT_NOT_FINITE = -1,   /* NaN or infinity in position or orientation */
  PALPATE_FAULT_TIME_STEP = -2,    /* dt_s negative, NaN or above one second */
  PALPATE_FAULT_ENERGY = -3,       /* the energy account did not close */
  PALPATE_FAULT_SLOW_STALLED = -4, /* in contact, and no element for too long */
  /* Not of a tool: never latched. */
  PALPATE_ERROR_INTERNAL = -101, /* a bug in palpate, or no memory */
  PALPATE_ERROR_INPUT = -102,    /* a null pointer, or a call that is not allowed */
  PALPATE_ERROR_FORMAT = -103    /* the database is damaged */
};

enum palpate_flags {
  /* No thread: the host calls palpate_slow_step(), about 100 times a second. */
  PALPATE_OWN_SLOW_STEPS = 1,
  /* Scales forces where the device could not render the body's stiffness, instead of
   * refusing to open. */
  PALPATE_LIMIT_STIFFNESS = 2,
  /* The database stays in its file; what is near the tool is in memory. */
  PALPATE_STREAMED = 4,
  /* The file is a scene (TOML), rendered while its responses are computed: by
   * palpate-precompute serve, which is joined where it listens, else started and ended
   * with the body. palpate_open() waits for its first message, a minute at most. Where
   * nothing is known yet there is no force. Under the tool the account takes answers in
   * by steps, in 10 ms at most a twentieth of a place's largest force ("potential", no
   * slivers); friction comes on top. Not for tools of several contacts, nor for bodies
   * that relax or yield. With the device's damping given, PALPATE_LIMIT_STIFFNESS must
   * be set: what turns out too stiff is softened, place by place. */
  PALPATE_SCENE = 8,
  /* Of a scene: where nothing is known yet, the force of a half space of the body's own
   * material (no form, supports or large strains: mostly too stiff, on a
   * small organ up to eight times). */
  PALPATE_ESTIMATE = 16,
  /* Of palpate_step(): the devices give forces alone. A tool of several contacts then
   * turns at no gain for the hand, as of palpate_force(). */
  PALPATE_FORCES_ALONE = 32
};

/* What the place under the tool answers with. */
enum palpate_answer {
  PALPATE_ANSWER_NONE = 0,        /* nothing is known yet, or nobody reaches there */
  PALPATE_ANSWER_ESTIMATED = 1,   /* as of a half space: PALPATE_ESTIMATE */
  PALPATE_ANSWER_PRELIMINARY = 2, /* linear, on a coarse mesh */
  PALPATE_ANSWER_FINAL = 3        /* as the finished database has it */
};

/* How the service of a scene is. Whatever it is, what was answered is rendered. */
enum palpate_service_state {
  PALPATE_SERVICE_NONE = 0,     /* the body is a database */
  PALPATE_SERVICE_JOINING = 1,  /* another one starts */
  PALPATE_SERVICE_SERVING = 2,  /* messages come */
  PALPATE_SERVICE_SILENT = 3,   /* none for three seconds */
  PALPATE_SERVICE_LOST = 4,     /* gone; joined again as soon as one listens */
  PALPATE_SERVICE_NONSENSE = 5, /* what came was no message; joined again */
  PALPATE_SERVICE_OTHER = 6,    /* who listens there computes another scene */
  PALPATE_SERVICE_DONE = 7,     /* the database is whole */
  PALPATE_SERVICE_FAILED = 8    /* there will be none */
};

/* Zero in any member means its default. */
typedef struct palpate_options {
  size_t struct_size;      /* sizeof(palpate_options) */
  const char* tool_name;   /* NULL: the database's only tool */
  double metres_per_unit;  /* [m] [1e-6, 1e6], host's unit of length; 1 */
  double newtons_per_unit; /* [N] [1e-6, 1e6], host's unit of force; 1 */
  /* A host that scales its workspace makes the device feel position_gain * force_gain
   * times the body's stiffness: the stability bound holds there. */
  double position_gain;  /* [-] [1e-6, 1e6], movement here per device movement; 1 */
  double force_gain;     /* [-] [1e-6, 1e6], device force per force given here; 1 */
  double nominal_tick_s; /* [s] (0, 1], what dt_s 0 means; 0.001 */
  double slow_hz;        /* [Hz] [1, 1000], of the slow process; 100 */
  double device_damping_n_s_per_m; /* [N s/m] > 0, viscous; 0: unknown, no bound is
                                      checked (palpate_needed_damping()) */
  double device_delay_s;           /* [s] >= 0, from command to force; 0 */
  double force_max_n;              /* [N] > 0, at the device; 8 */
  double stall_s; /* [s] > 0, in contact without an element: fault; 0.5 */
  double ramp_s;  /* [s] > 0, from start or reset to the full force; 0.1 */
  uint32_t flags; /* of enum palpate_flags */
  /* Local model, of the passive ones: "potential" (NULL), "facets", "element",
   * "energy-tank", "equal-energy". */
  const char* model;
  double device_angular_damping_n_m_s; /* [N m s] > 0, viscous, of turns; 0: unknown,
                                          turning of several contacts is not checked */
  /* Of a scene alone. */
  const char* server; /* the program palpate-precompute; NULL: beside the host's own
                         program, or in PATH */
  const char* output; /* the database that is computed; NULL: the scene's name with .h5,
                         in the present folder */
} palpate_options;

/* The latest tick. Energies are those of the body, not of a scaled device. */
typedef struct palpate_state {
  size_t struct_size;      /* sizeof(palpate_state), set by the caller */
  int32_t status;          /* as palpate_force() returned it */
  int32_t triangle;        /* of the database, in use; -1: none */
  double contact_point[3]; /* [host length] on the surface at rest */
  double normal[3];        /* [-] there, outward; zero: no element yet */
  double force[3];         /* [host force] on the tool */
  double depth;            /* [host length] penetration */
  double work_j;           /* [J] put in by the tool since the start; >= 0: passive */
  double stored_j;         /* [J] in the local model */
  double tank_j;           /* [J] >= 0 that changes of the model freed */
  double dissipated_j;     /* [J] >= 0 by friction and discarded surplus */
  double rest_offset;      /* [host length] >= 0 that the energy account had to take */
  double force_scale;      /* [-] (0, 1], below 1 by PALPATE_LIMIT_STIFFNESS */
  double tilt_rad;         /* [rad] between the tool's orientation and the one that the
                              responses are of; 0 without */
  int32_t starved;         /* the element under the tool had not arrived */
  int32_t extrapolated;    /* deeper than the response was computed */
  uint64_t ticks;          /* since the start or the last reset */
  /* Of a body that relaxes; else 0. */
  double memory_j;      /* [J] >= 0 in dents that have not recovered:
                           work = stored + tank + dissipated + memory */
  double relaxed_force; /* [host force] >= 0, what has relaxed of the normal force */
  /* Of a body that yields; else 0. */
  double yielded_j; /* [J] >= 0 dissipated by dents and softening since the start */
  double dent;      /* [host length] >= 0, depth that stays under the tool */
  /* Of a tool with several contacts; contact_point, normal and triangle are of the one
   * that carries most, depth of the deepest. */
  double torque[3];        /* [host force x host length] about the reference point */
  int32_t contacts;        /* that carry something */
  int32_t coupling_scaled; /* 1: some lie too close to be coupled as they are */
  /* Of two hands: on the second one's tool; force and torque are the first one's, the
   * energies those of both together. */
  double second_force[3];
  double second_torque[3];
  int32_t answer; /* of enum palpate_answer; of a database always final */
} palpate_state;

/* Of the service of a scene. */
typedef struct palpate_service {
  size_t struct_size; /* sizeof(palpate_service), set by the caller */
  int32_t state;      /* of enum palpate_service_state */
  int32_t started;    /* 1: it is this process' child, and ends with the body */
  int64_t nodes;      /* that get an answer, */
  int64_t answered;   /* have one, */
  int64_t finished;   /* have the one that the database will have */
  int64_t softened;   /* answers that were too stiff for the device */
  char detail[256];   /* why, or the finished database's path; one line */
} palpate_service;

/* Where a hand's tool is. */
typedef struct palpate_pose {
  double position[3];  /* [host length] of the tool's reference point */
  double quat_xyzw[4]; /* its orientation, of any length; zeros: none */
} palpate_pose;

/* On a hand's tool. */
typedef struct palpate_hand_wrench {
  double force[3];  /* [host force] */
  double torque[3]; /* [host force x host length] about the reference point */
} palpate_hand_wrench;

typedef struct palpate_body palpate_body;
typedef struct palpate_tool palpate_tool;

/* PALPATE_ABI_VERSION that the library was built with. */
PALPATE_API int palpate_abi_version(void);

/* Zeros, and struct_size: every default. */
static inline void palpate_options_init(palpate_options* options) {
  memset(options, 0, sizeof *options);
  options->struct_size = sizeof *options;
}

/* Opens a response database. NULL on failure, with one line in error (may be NULL):
 * what, which value, what was allowed. options may be NULL. */
PALPATE_API palpate_body* palpate_open(const char* file, const palpate_options* options,
                                       char* error, size_t error_bytes);

/* One for each tool of the host, at most 16 of a body; NULL on failure. Lives as long
 * as the body. Of a body that relaxes every tool finds its own dents alone, not those
 * of the others: each may be called in a thread of its own. So does every contact of a
 * tool with several, and each of two hands. */
PALPATE_API palpate_tool* palpate_tool_add(palpate_body* body);

/* The same, with one line in error (may be NULL) where it fails: no memory, a 17th
 * tool, a budget that does not hold a streamed neighbourhood. */
PALPATE_API palpate_tool* palpate_tool_open(palpate_body* body, char* error,
                                            size_t error_bytes);

/* Two hands on one body, a pinch: one more tool of the body, whose hands feel each
 * other through it by the table that the database holds. The first hand has the body's
 * tool, the second the tool of that name (NULL: another of the same kind). Model
 * "potential"; not of a scene. The device's bound is checked for each hand's tool by
 * itself, and palpate_needed_damping() is the first one's: another hand that is held
 * still makes the body somewhat stiffer than that. NULL on failure, with one line in
 * error (may be NULL). */
PALPATE_API palpate_tool* palpate_together_open(palpate_body* body,
                                                const char* second_tool, char* error,
                                                size_t error_bytes);

/* Viscous damping [N s/m] that the device must have at least, at the device, so that a
 * hand cannot be given energy by the forces that are held between ticks: K (T/2 +
 * delay), K the largest stiffness of the body as it is felt, T the nominal tick. With
 * device_damping_n_s_per_m unknown (0) nobody has checked it: a device with less may
 * vibrate on a stiff spot, however exact the account of the forces is. Of a scene: by
 * the answers that its tools have got so far. */
PALPATE_API double palpate_needed_damping(const palpate_body* body);

/* HDF5 is not thread-safe, and this library uses the process's: in palpate_open(), and
 * with PALPATE_STREAMED or PALPATE_SCENE in threads of its own until palpate_close(). A
 * host that calls HDF5 itself, in any thread, does so between these two; they nest in
 * one thread and may wait for the reading of a chunk (milliseconds). Never in the
 * haptic thread. */
PALPATE_API void palpate_hdf5_lock(void);
PALPATE_API void palpate_hdf5_unlock(void);

/* How the service of a scene is; for a body of a database all zero. 0, or an error
 * below zero. Not in the haptic thread. */
PALPATE_API int palpate_service_get(palpate_body* body, palpate_service* service);

/* One turn of the slow process for all tools; only with PALPATE_OWN_SLOW_STEPS.
 * Elements sent, or an error below zero. */
PALPATE_API int palpate_slow_step(palpate_body* body);

/* 0 while the slow process is well, else the error that ended it, with a line of text
 * (may be NULL). */
PALPATE_API int palpate_slow_failure(palpate_body* body, char* text, size_t text_bytes);

/* How the body stands in the host's world: position [host length] of its frame's
 * origin, quat_xyzw (may be NULL) from its frame to the world's. From then on poses,
 * forces, torques, contact points, normals, vertices are the world's. While no tick of
 * the body's tools is under way, and no other call of the body; a tool that stands
 * still is then moved through the body as any movement moves it. 0, or
 * PALPATE_ERROR_INPUT for what is not finite or no orientation: nothing changes. */
PALPATE_API int palpate_place(palpate_body* body, const double position[3],
                              const double quat_xyzw[4]);

/* How many vertices and triangles the body's surface at rest has. Of a streamed body
 * PALPATE_ERROR_INPUT; so the next. */
PALPATE_API int palpate_mesh_count(const palpate_body* body, size_t* vertices,
                                   size_t* triangles);

/* The surface at rest, to be drawn: vertices (3 each) [host length], triangles (3
 * vertices each, from 0, anticlockwise from outside). Either may be NULL. */
PALPATE_API int palpate_mesh_get(const palpate_body* body, double* vertices,
                                 int32_t* triangles);

/* Forces [host force] on the body's tool at rest at positions (3 each) [host length],
 * without friction, memory or history: each by itself. Of tools of one contact, of a
 * database in memory that does not yield. Allocates; any thread. 0, or an error below
 * zero with one line in error (may be NULL). */
PALPATE_API int palpate_query(palpate_body* body, const double* positions, size_t count,
                              double* forces_out, char* error, size_t error_bytes);

/* Haptic thread: one tick of a tool. poses and wrenches_out: one of each hand, of which
 * palpate_together_open() gives two and any other tool has one. Of one contact the
 * torque is zero: it acts at the reference point. Of several, force and torque are the
 * gradient of one potential of the poses, with the contacts coupled through the body,
 * and the hand must feel the torque: else PALPATE_FORCES_ALONE. Without an orientation
 * a tool's frame lies along the body's, or the world's where the body is placed. dt_s,
 * what is returned, what is guaranteed: as of palpate_force(). */
PALPATE_API int palpate_step(palpate_tool* tool, const palpate_pose* poses,
                             size_t hands, double dt_s,
                             palpate_hand_wrench* wrenches_out);

/* Haptic thread: one tick. Never allocates, locks, throws, waits or reads a clock.
 * position [host length]: of the tool's reference point, a sphere's centre.
 * quat_xyzw: orientation, of any length; NULL or zero: none. Responses of one contact
 * are of one orientation: another one changes tilt_rad alone. A tool of several
 * contacts turns, and the hand gains nothing by it: no torque is felt, so what the
 * turned tool would store is taken from the force. dt_s: since the last call, at most
 * 1; 0: the nominal tick. No outlier is rejected: a host that reads a device validates
 * positions before the call. force_out [host force]: on the tool; zero in free space
 * and on a fault. Returns PALPATE_CONTACT, PALPATE_FREE, or a fault below zero. */
PALPATE_API int palpate_force(palpate_tool* tool, const double position[3],
                              const double quat_xyzw[4], double dt_s,
                              double force_out[3]);

/* Haptic thread: palpate_step() of one hand. torque_out [host force x host length]:
 * about the reference point. A host that gives less than the torque says so by
 * palpate_delivered(). Where the device feels force_gain times the force and moves 1 /
 * position_gain as far, it feels force_gain / position_gain times the torque. */
PALPATE_API int palpate_wrench(palpate_tool* tool, const double position[3],
                               const double quat_xyzw[4], double dt_s,
                               double force_out[3], double torque_out[3]);

/* Haptic thread: palpate_step() of two hands. positions: x y z of the first hand's
 * tool, then of the second's; so the others: quats_xyzw (8, may be NULL; four zeros:
 * none), forces_out (6), torques_out (6; NULL: no torque is felt, as of
 * palpate_force()). Returns PALPATE_CONTACT where either touches. */
PALPATE_API int palpate_together(palpate_tool* tool, const double positions[6],
                                 const double quats_xyzw[8], double dt_s,
                                 double forces_out[6], double torques_out[6]);

/* Haptic thread, between two ticks: what the device made of the latest force and
 * torque, where that is not what was asked for: motors that saturate, limits of the
 * host's. The account is then of what was felt, and a device that gives a hand more
 * energy than 10 mJ is the fault "energy". force (3; of two hands 6) [host force],
 * torque likewise [host force x host length]; NULL: as it was asked for. 0, or
 * PALPATE_ERROR_INPUT for what is not finite, which changes nothing. */
PALPATE_API int palpate_delivered(palpate_tool* tool, const double* force,
                                  const double* torque);

/* The haptic thread, or one other, but always the same one: there is one reader. Fills
 * the first struct_size bytes; what the library does not know, with zeros. */
PALPATE_API void palpate_state_get(palpate_tool* tool, palpate_state* state);

/* While no other call of the tool is under way, and not in a tick: it clears 0.4 MB for
 * each contact of a tool with several, 0.4 ms of three, 3 ms of 64. Clears a fault, the
 * account, what is known of the tool's place, as after a jump, and what a body that
 * relaxes remembers of this tool. Dents that stay and curves that have softened stay:
 * palpate_surface_load() with no file makes the body fresh. The next slow step finds
 * the tool again; the force ramps up anew. */
PALPATE_API void palpate_reset(palpate_tool* tool);

/* While no other call of the tool is under way: writes what the body keeps of this
 * tool's presses for good, of two hands' likewise, for palpate_surface_load() and
 * palpate-run --surface-in. A file that has the surface of the same body keeps what it
 * says of other tools. 0, or an error below zero with a line (may be NULL). */
PALPATE_API int palpate_surface_save(palpate_tool* tool, const char* file, char* error,
                                     size_t error_bytes);

/* While no other call of the tool is under way: palpate_reset(), on a body that has
 * yielded as the file says; NULL: a fresh one. A file of another body is refused, and
 * nothing changes then. 0, or an error below zero with a line (may be NULL). */
PALPATE_API int palpate_surface_load(palpate_tool* tool, const char* file, char* error,
                                     size_t error_bytes);

/* "free", "contact", "not-finite", ...: never NULL, lives for ever. Any thread. Those
 * of palpate-run's devices, -5 to -9, are "device-lost", "deadlines", "device-silent",
 * "jump" and "slow-wire". */
PALPATE_API const char* palpate_fault_name(int status);

/* Ends the slow process and frees the body with its tools. NULL is allowed. */
PALPATE_API void palpate_close(palpate_body* body);

/* NOLINTEND(readability-identifier-naming) */

#ifdef __cplusplus
} /* extern "C" */
#endif

#endif /* PALPATE_H */
