; BROKEN     Twin of 05f_slower_robot_is_no_worse.smt2: the other robot is faster.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const A Real)        ; greatest acceleration
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const s Real)        ; robot's own way since the thing was seen
(declare-const age Real)      ; time since the thing was seen
(declare-const d Real)        ; clearance when the thing was seen
(declare-const c Real)        ; commanded speed
(declare-const u Real)        ; bound of the robot's present speed
(declare-const u1 Real)       ; another bound of the robot's present speed
; Formulas
(define-fun way_to_rest ((w Real)) Real (+ (* w eps) (/ (* w w) (* 2 b))))
(define-fun time_to_rest ((w Real)) Real (+ eps (/ w b)))
(define-fun need ((kappa Real) (V Real) (s Real) (age Real) (w Real)) Real
  (+ (* kappa (+ s (way_to_rest w))) (* V (+ age (time_to_rest w)))))
(define-fun fastest ((c Real) (u Real)) Real (ite (>= (+ c (* A eps)) u) (+ c (* A eps)) u))

; Assumptions
(assert (>= A 0))
(assert (> b 0))
(assert (> eps 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= s 0))
(assert (>= age 0))
(assert (>= c 0))
(assert (>= u 0))
(assert (>= u1 0))
(assert (<= (need kappa V s age (fastest c u)) d))
(assert (>= u1 u))                                           ; BROKEN: turned round

; Conclusion, negated
(assert (not (<= (need kappa V s age (fastest c u1)) d)))
(check-sat)
