; BROKEN     Twin of 01a_braking_keeps_safe.smt2: the safe state forgets the way of the thing
;            while the robot brakes.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const r Real)        ; what is left of the clearance
(declare-const v Real)        ; speed of the robot
(declare-const v1 Real)       ; speed afterwards
(declare-const t Real)        ; time that passes
(declare-const x Real)        ; robot's own way meanwhile
; Formulas
(define-fun safe ((v Real) (r Real)) Bool (<= (* kappa v v) (* 2 b r))) ; BROKEN: 2 V v is missing

; Assumptions
(assert (> b 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= v 0))
(assert (>= v1 0))
(assert (>= t 0))
(assert (>= x 0))
(assert (<= v1 v))
(assert (<= (* b t) (- v v1)))                    ; braking at b takes at most this long
(assert (<= (* 2 b x) (- (* v v) (* v1 v1))))     ; and at most this way: 01b, 01c
(assert (safe v r))

; Conclusion, negated
(assert (not (safe v1 (- r (* kappa x) (* V t)))))
(check-sat)
