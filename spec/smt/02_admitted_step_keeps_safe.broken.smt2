; BROKEN     Twin of 02_admitted_step_keeps_safe.smt2: the time in which the thing comes nearer
;            forgets the reaction time.
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
(declare-const t Real)        ; time that passes
(declare-const x Real)        ; robot's own way meanwhile
(declare-const v1 Real)       ; speed afterwards
; Formulas
(define-fun fits ((w Real)) Bool
  (<= (+ (* kappa (+ (* 2 b s) (* 2 b w eps) (* w w))) (* 2 V (+ (* b age) w))) (* 2 b d))) ; BROKEN: b eps is missing
(define-fun fastest ((c Real) (u Real)) Real (ite (>= (+ c (* A eps)) u) (+ c (* A eps)) u))
(define-fun safe ((v Real) (r Real)) Bool (<= (+ (* kappa v v) (* 2 V v)) (* 2 b r)))

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
(assert (>= t 0))
(assert (>= x 0))
(assert (>= v1 0))
(assert (fits (fastest c u)))
(assert (<= t eps))
(assert (<= x (* (fastest c u) t)))
(assert (<= v1 (fastest c u)))

; Conclusion, negated
(assert (not (safe v1 (- d (* kappa (+ s x)) (* V (+ age t))))))
(check-sat)
