/* A library of our own with the names of OpenHaptics' functions: one device, a scheduler
 * of 1 kHz in a thread, a stack of errors; its stand_in_ functions are for the tests. */
#define _GNU_SOURCE
#include <pthread.h>
#include <stddef.h>
#include <string.h>
#include <time.h>

typedef struct {
  unsigned code;
  int internal;
  unsigned device;
} Error;

int stand_in_has_device = 1;
unsigned stand_in_calibration = 0x5000;
volatile int stand_in_stalls = 0; /* the scheduler stands still */
volatile int stand_in_running = 0;
int stand_in_enabled = 0;

static unsigned (*task)(void*);
static void* task_data;
static pthread_t thread;
static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
/* By columns. */
double stand_in_transform[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

static double force_n[3], position_mm[3];
static unsigned errors[8];
static int error_count = 0;

void stand_in_push_error(unsigned code) {
  pthread_mutex_lock(&mutex);
  errors[error_count++ % 8] = code;
  pthread_mutex_unlock(&mutex);
}

void stand_in_turn(const double* transform) {
  pthread_mutex_lock(&mutex);
  memcpy(stand_in_transform, transform, sizeof stand_in_transform);
  pthread_mutex_unlock(&mutex);
}

void stand_in_force(double* f) {
  pthread_mutex_lock(&mutex);
  for (int i = 0; i < 3; ++i) {
    f[i] = stand_in_enabled && stand_in_running ? force_n[i] : 0.0;
  }
  pthread_mutex_unlock(&mutex);
}

static void* run(void* unused) {
  const struct timespec tick = {0, 1000000};
  (void)unused;
  while (stand_in_running) {
    if (!stand_in_stalls) {
      task(task_data);
    }
    nanosleep(&tick, NULL);
  }
  return NULL;
}

unsigned hdInitDevice(const char* name) {
  if (!stand_in_has_device || (name != NULL && strcmp(name, "Left") != 0)) {
    stand_in_push_error(0x0201);
    return 0xFFFFFFFFU;
  }
  return 5;
}
unsigned hdCheckCalibration(void) { return stand_in_calibration; }
void hdDisableDevice(unsigned device) { (void)device; }
void hdEnable(unsigned what) { stand_in_enabled = what == 0x4000; }
void hdStartScheduler(void) {
  stand_in_running = 1;
  pthread_create(&thread, NULL, run, NULL);
}
void hdStopScheduler(void) {
  stand_in_running = 0;
  pthread_join(thread, NULL);
}
unsigned long hdScheduleAsynchronous(unsigned (*f)(void*), void* data, unsigned short p) {
  (void)p;
  task = f;
  task_data = data;
  return 1;
}
void hdUnschedule(unsigned long handle) { (void)handle; }
void hdBeginFrame(unsigned device) { (void)device; }
void hdEndFrame(unsigned device) { (void)device; }
void hdGetDoublev(unsigned what, double* values) {
  if (what == 0x2050) {
    memcpy(values, position_mm, sizeof position_mm);
  } else if (what == 0x2052) {
    pthread_mutex_lock(&mutex);
    memcpy(values, stand_in_transform, sizeof stand_in_transform);
    pthread_mutex_unlock(&mutex);
  } else if (what == 0x2603) {
    values[0] = 0.88;
  }
}
void hdSetDoublev(unsigned what, const double* values) {
  pthread_mutex_lock(&mutex);
  if (what == 0x2700) {
    for (int i = 0; i < 3; ++i) {
      force_n[i] = values[i];
      position_mm[i] += 0.01 * values[i];
    }
  }
  pthread_mutex_unlock(&mutex);
}
Error hdGetError(void) {
  Error error = {0, 0, 5};
  pthread_mutex_lock(&mutex);
  if (error_count > 0) {
    error.code = errors[--error_count % 8];
  }
  pthread_mutex_unlock(&mutex);
  return error;
}
const char* hdGetErrorString(unsigned code) {
  return code == 0x0201 ? "Device fault" : code == 0x0301 ? "Warm motors" : "Some error";
}
